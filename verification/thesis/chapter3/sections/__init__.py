"""The sections of the chapter on the tissue, one file for each study or two."""
