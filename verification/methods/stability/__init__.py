"""Where methods fail: maps with the limits that theory predicts, and single failures."""
