"""What every command stands on: configurations, flags, console, files, case folders. Knows no study and no renderer."""
