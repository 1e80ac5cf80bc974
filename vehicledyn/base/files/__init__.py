"""Files that users name: what may be read, who may write, columns, whole or not at all."""
