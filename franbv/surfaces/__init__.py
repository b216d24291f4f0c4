"""What is known of a part's surfaces before they are looked at."""
