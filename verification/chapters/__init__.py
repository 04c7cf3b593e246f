"""The chapters of the report, one file each, in their order."""

from verification.chapters import claims, emt, geometry, meanfield, numerics, stability, tissue, work_precision
from verification.report import Chapter

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
