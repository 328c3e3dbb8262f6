-- The index of a scene in two parts, of which a server of many scenes reads the first alone. It is derived: what was stored is of no use
-- any more, and `optimize` makes it anew. README.md beside this file explains the columns.

DROP TABLE scene_index;

CREATE TABLE scene_index (
  segment_id   INTEGER PRIMARY KEY REFERENCES segment (id) ON DELETE CASCADE,
  version      INTEGER NOT NULL,
  params       TEXT NOT NULL,
  codes        BLOB NOT NULL,
  digest       TEXT NOT NULL CHECK (length(digest) = 64),
  tails        BLOB NOT NULL,
  tails_digest TEXT NOT NULL CHECK (length(tails_digest) = 64)
) STRICT;
