"""CSV tables: the writer, and the columns of every table."""
