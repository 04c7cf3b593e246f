"""The text of the thesis: quotations with their corrections, one file a chapter, and errata of notation."""
