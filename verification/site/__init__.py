"""The site: tables, figures and claims for pages in Markdown, put into them by a Sphinx extension."""
