"""What the columns of the tables on the page are called."""

PRINTED = {
    "preset": "Preset",
    "time_h": "At [h]",
    "scenario": "Scenario",
    "what": "Outcome",
    "printed": "Printed",
    "measured": "Measured",
    "runs": "Runs",
    "low": "Difference from",
    "high": "to",
    "agrees": "Agrees",
}
RATIOS = {
    "study": "Study",
    "scenario": "Scenario",
    "what": "Outcome",
    "value": "Ratio",
    "low": "from",
    "high": "to",
    "of": "Cells",
    "effective": "Effective",
    "runs": "Runs",
}
CATEGORIES = {"scenario": "Group", "category": "Cells with", **{key: RATIOS[key] for key in ("value", "low", "high")}}
CATEGORIES |= {"of": "Cells", "study": "Study"}
ANSWERS = {
    "preset": "Preset",
    "id": "",
    "question": "Question",
    "thesis": "Thesis",
    "verdict": "Verdict",
    "needed": "Runs needed",
}
COMPARISONS = {"preset": "Preset", "id": "", "measured": "Measured"}
CONTROLS = {
    "study": "Study",
    "runs": "Runs",
    "failed": "Failed",
    "apical": "Above the apical layer",
    "apical_low": "from",
    "apical_high": "to",
    "basal": "Below the basal layer",
}
RANKING = {
    "preset": "Preset",
    "factor": "Factor",
    "value": "Importance [nats]",
    "low": "from",
    "high": "to",
    "loss": "Loss of the model [nats]",
    "without": "without it",
    "cells": "Cells",
}
SENSITIVITY = {
    "parameter": "Parameter",
    "S1": "Alone (S1)",
    "S1_low": "from",
    "S1_high": "to",
    "ST": "With others (ST)",
    "ST_low": "from ",
    "ST_high": "to ",
}
