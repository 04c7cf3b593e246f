"""The page: its parts, its look, and the templates that they are put into."""
