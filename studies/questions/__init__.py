"""Questions of an architect: a study file, the text of a page and what is read off, each."""
