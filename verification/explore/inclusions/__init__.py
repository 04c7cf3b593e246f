"""The tab of inclusions: problems, methods, runs, their pictures and charts."""
