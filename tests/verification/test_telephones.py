"""A chart for telephones has its panels below each other, each with the labels that it shared."""

from itertools import pairwise

from matplotlib.lines import Line2D

from tissue.pictures.charts import caption, legend
from tissue.study.figures.panels import grid, name_axes
from verification.page.sheet import NARROW
from verification.page.telephones import stack_chart


def test_panels_stand_below_each_other_with_labels_legend_and_caption() -> None:
    figure, panels = grid(["one", "other"], ["thesis", "published"], 1.5, sharex=True, sharey=True)
    name_axes(panels, "time [h]", "ratio [%]")
    legend(figure, {"first": Line2D([], [], color="red"), "second": Line2D([], [], marker="o")})
    caption(figure, "What is drawn, of how many cells, and what the intervals are: 95 % intervals. " * 2)
    stack_chart(figure)
    figure.draw_without_rendering()
    boxes = [panel.get_tightbbox() for panel in panels.values()]
    assert all(above.y0 >= below.y1 for above, below in pairwise(boxes))
    assert {panel.get_xlabel() for panel in panels.values()} == {"time [h]"}
    assert {panel.get_ylabel() for panel in panels.values()} == {"ratio [%]"}
    assert figure.get_figwidth() == NARROW
    (only,) = figure.legends
    assert [text.get_text() for text in only.get_texts()] == ["first", "second"]
    assert only.legend_handles[1].get_marker() == "o"
    assert only.get_window_extent().y0 >= boxes[0].y1
    assert figure.get_supxlabel().count("\n") >= 2
    assert all(0 <= box.x0 < box.x1 <= figure.bbox.width for box in boxes)


def test_a_chart_without_legend_and_caption_is_stacked() -> None:
    figure, panels = grid(["one", "other"], ["thesis"], 1.5)
    stack_chart(figure)
    assert [panel.get_subplotspec().rowspan.start for panel in panels.values()] == [0, 1]
