"""What is true of a derivation, without words: the templates of notes say it."""
