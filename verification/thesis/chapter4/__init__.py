"""The EMT studies of chapter 4: run, summed up, compared with what the thesis prints."""
