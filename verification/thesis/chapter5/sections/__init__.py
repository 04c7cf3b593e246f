"""The sections of the mean-field chapter, one file each."""
