"""What the columns of the tables on the page are called, and what its figures show."""

# Of the presets beside each other: what the rows are of, then what is shown of each preset.
PRINTED = ({"scenario": "Scenario", "what": "Outcome", "printed": "Printed"}, {"shown": ""})
RATIOS = (
    {"study": "Study", "scenario": "Scenario", "what": "Outcome"},
    {"ratio": "[95 %]", "effective": "effective cells", "runs": "runs"},
)
PROGRAMS = ({"scenario": "Scenario"}, {"ratio": "[95 %]", "effective": "effective cells"})
CATEGORIES = ({"scenario": "Group", "category": "Cells with"}, {"ratio": "[95 %]", "of": "cells"})
ANSWERS = (
    {"id": "", "question": "Question", "thesis": "Answer of the thesis"},
    {"verdict": "preset", "needed": "preset, runs needed"},
)
COMPARISONS = ({"id": "", "compared": "Compared"}, {"found": "preset"})
CONTROLS = (
    {"study": "Study"},
    {"ratio": "above the apical layer", "basal": "below the basal layer", "failed": "failed"},
)
RANKING = ({"factor": "Factor"}, {"number": "[95 %]"})
SENSITIVITY = {
    "parameter": "Parameter",
    "S1": "Alone (S1)",
    "S1_low": "from",
    "S1_high": "to",
    "ST": "With others (ST)",
    "ST_low": "from ",
    "ST_high": "to ",
}
# The figures of chapter 4 of the thesis, by their numbers.
FIGURES = {
    10: "Ratios of isolated cells with one event, in time",
    11: "Isolated cells with [A]",
    12: "Ratios of isolated cells without INM, in time",
    13: "Isolated cells at the end",
    14: "Isolated cells with [A] and [B] at different times",
    15: "Eleven programs of events, alone and in groups",
    16: "Cells with [B] without INM, alone and in a group",
    17: "Cells with [A], then [B], in different environments",
    18: "Cells with [A] alone in different environments",
    19: "Cells with [B] alone in different environments",
    20: "Basal extrusion given the time of an event",
    21: "Basal extrusion given the position at the onset",
    22: "Positions at the onset and at the end",
}
CHECKED = (13, 15, 17, 18, 19)  # over these the runs of the page are laid
