"""A chart of sensitivities as a page of its own."""

from collections.abc import Sequence
from typing import Any

from pareto_monoped.measures import Measure
from pareto_monoped.uncertainty.influences import Sensitivity

_TITLES = {"variables": "variables, moved a little", "assumptions": "what is uncertain in a built robot"}
_COLOURS = ("#3b6ea8", "#b5651d")
_ROW_PX, _MARGIN_PX = 26, 150


def sensitivity_figure(trial: int, found: Sequence[Sensitivity], shown: Sequence[Measure]) -> Any:
    """Bars of total Sobol' indices with their 95 percent intervals, a panel per kind of factors.

    Args:
        trial: the design.
        found: its sensitivities.
        shown: measures, in the order of their bars.
    """
    from plotly.graph_objects import Bar, Figure
    from plotly.subplots import make_subplots

    counts = [len(one.factors) for one in found]
    figure: Figure = make_subplots(
        rows=len(found),
        cols=1,
        row_heights=[count / sum(counts) for count in counts],
        vertical_spacing=0.12,
        subplot_titles=[f"{_TITLES[one.about]} ({one.jumps} jumps)" for one in found],
    )
    for row, sensitivity in enumerate(found, 1):
        # The greatest stands at the top, and plotly begins at the bottom.
        ranked = sensitivity.ranked(shown[0].name)[::-1]
        for entry, colour in zip(shown, _COLOURS, strict=False):
            influences = [factor.measures[entry.name] for factor in ranked]
            figure.add_trace(
                Bar(
                    orientation="h",
                    name=entry.words,
                    legendgroup=entry.name,
                    showlegend=row == 1,
                    marker_color=colour,
                    y=[f"{factor.factor.label}, {factor.factor.text}" for factor in ranked],
                    x=[100.0 * influence.total for influence in influences],
                    error_x={"type": "data", "array": [100.0 * influence.error for influence in influences]},
                    customdata=[
                        f"{influence.change * entry.scale:+.3g} {entry.shown_unit}" for influence in influences
                    ],
                    hovertemplate="%{y}<br>%{x:.0f} % of the variance<br>%{customdata} from end to end<extra></extra>",
                ),
                row=row,
                col=1,
            )
        figure.update_xaxes(title_text="share of the variance in percent (total Sobol' index)", row=row, col=1)
    figure.update_layout(
        title=f"Sensitivity of trial {trial}",
        template="plotly_white",
        barmode="group",
        height=_MARGIN_PX * len(found) + _ROW_PX * sum(counts),
        margin={"l": 10, "r": 10},
    )
    figure.update_yaxes(automargin=True)
    return figure


def sensitivity_page(trial: int, found: Sequence[Sensitivity], shown: Sequence[Measure]) -> str:
    """The chart as HTML that needs no network."""
    text: str = sensitivity_figure(trial, found, shown).to_html(include_plotlyjs=True, full_html=True)
    return text
