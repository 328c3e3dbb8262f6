-- Codes of each segment's descriptors, for catalogues too large to be compared in full. README.md beside this file explains them.

CREATE TABLE scene_index (
  segment_id INTEGER PRIMARY KEY REFERENCES segment (id) ON DELETE CASCADE,
  version    INTEGER NOT NULL,
  params     TEXT NOT NULL,
  codes      BLOB NOT NULL,
  digest     TEXT NOT NULL CHECK (length(digest) = 64)
) STRICT;
