"""The sections of the chapter on the tissue in three dimensions."""
