"""The chapters of the report, one file each, in their order."""

from verification.page.report import Chapter
from verification.thesis import statements as claims
from verification.thesis.chapter1 import page as geometry
from verification.thesis.chapter2 import page as numerics
from verification.thesis.chapter2 import page_work_precision as work_precision
from verification.thesis.chapter2.stability import page as stability
from verification.thesis.chapter3 import page as tissue
from verification.thesis.chapter4 import page as emt
from verification.thesis.chapter5 import page as meanfield

# The claims read the tables of all other chapters, so they come last.
CHAPTERS: tuple[Chapter, ...] = (
    numerics.CHAPTER,
    work_precision.CHAPTER,
    stability.CHAPTER,
    geometry.CHAPTER,
    tissue.CHAPTER,
    emt.CHAPTER,
    meanfield.CHAPTER,
    claims.CHAPTER,
)
