"""The questions: single frames, reconstructions, studies, datasets; the command line and the reports."""
