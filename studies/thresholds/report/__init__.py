"""The certificate as a page."""
