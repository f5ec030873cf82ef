"""Study databases -> one self-contained HTML page, and figures for print.

Order of imports, lowest first: schema; exports, front_figure, packing, quantities; comparison, figures, motors,
resimulation, robust, tables, trials; context, summary; card; page.
"""

__all__ = ["figures", "page", "quantities", "schema", "tables"]
