"""What every command stands on: configurations, flags, console, case folders. Knows no study and no renderer."""
