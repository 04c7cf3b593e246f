"""Pictures and movies of the tissue. They make no numbers."""
