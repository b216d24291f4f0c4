"""One self-contained HTML page per result: figures as SVG, images as data URIs, no network."""
