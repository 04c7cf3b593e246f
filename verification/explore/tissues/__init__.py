"""The tab of the tissue: knobs, a session with its ensemble, pictures while a run goes on, the answer."""
