"""Why a pixel has no depth or a false one, decided by intervention."""
