"""Study databases -> one self-contained HTML page, and figures for print."""
