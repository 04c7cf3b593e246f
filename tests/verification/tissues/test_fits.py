"""The kept study of fits: coverage of intervals, and wrong models that are noticed."""

from verification.site.store import shipped
from verification.tissues.fits import HEIGHT, MISFIT_SEEN, OTHERS, OWN


def test_coverage_is_within_its_range():
    table = shipped("fit_coverage")
    for data, names in ((OWN, ("mu", "two_daughters")), (HEIGHT, ("mu", "two_daughters"))):
        rows = table[(table["data"] == data) & (table["points"] == 96)]
        assert len(rows) > 200
        for name in names:
            inside = (rows[f"{name}_low"] <= rows[name]) & (rows[name] <= rows[f"{name}_high"])
            assert 0.9 <= inside.mean() <= 0.99
        widths = (rows["two_daughters_high"] - rows["two_daughters_low"]).median()
        assert widths < 0.2 if data == OWN else widths > 0.45
        assert (rows["p"] < 0.05).mean() <= 0.1
    for name in OTHERS:
        rows = table[table["data"].str.startswith(f"preset {name},")]
        assert (rows["p"] < MISFIT_SEEN).mean() > 0.9
