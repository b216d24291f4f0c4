"""Charts as SVG, table cells, page templates. Knows no study."""
