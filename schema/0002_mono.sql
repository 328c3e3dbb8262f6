-- Monocular models. Every table, column and unit is explained in README.md beside this file.

CREATE TABLE mono_model (
  id             INTEGER PRIMARY KEY AUTOINCREMENT,
  name           TEXT NOT NULL UNIQUE CHECK (length(name) BETWEEN 1 AND 128),
  created        TEXT NOT NULL,
  source         TEXT NOT NULL,
  unit_scale     REAL NOT NULL CHECK (unit_scale > 0),
  diameter       REAL NOT NULL CHECK (diameter > 0),
  symmetry       TEXT NOT NULL,
  symmetries     BLOB NOT NULL CHECK (length(symmetries) > 0 AND length(symmetries) % 128 = 0),
  warnings       TEXT NOT NULL,
  damage         TEXT,
  digest         TEXT NOT NULL CHECK (length(digest) = 64),
  triples_digest TEXT NOT NULL CHECK (length(triples_digest) = 64)
) STRICT;

CREATE TABLE mono_feature (
  model_id  INTEGER NOT NULL REFERENCES mono_model (id) ON DELETE CASCADE,
  idx       INTEGER NOT NULL CHECK (idx >= 0),
  type      INTEGER NOT NULL CHECK (type BETWEEN 0 AND 3),
  x         REAL NOT NULL,
  y         REAL NOT NULL,
  z         REAL NOT NULL,
  nx        REAL,
  ny        REAL,
  nz        REAL,
  part      INTEGER,
  edge_mask BLOB NOT NULL,
  PRIMARY KEY (model_id, idx)
) STRICT, WITHOUT ROWID;

CREATE TABLE mono_edge (
  model_id INTEGER NOT NULL,
  a        INTEGER NOT NULL,
  b        INTEGER NOT NULL CHECK (a < b),
  PRIMARY KEY (model_id, a, b),
  FOREIGN KEY (model_id, a) REFERENCES mono_feature (model_id, idx) ON DELETE CASCADE,
  FOREIGN KEY (model_id, b) REFERENCES mono_feature (model_id, idx) ON DELETE CASCADE
) STRICT, WITHOUT ROWID;

CREATE TABLE mono_face (
  model_id    INTEGER NOT NULL REFERENCES mono_model (id) ON DELETE CASCADE,
  idx         INTEGER NOT NULL CHECK (idx >= 0),
  vertex_list BLOB NOT NULL CHECK (length(vertex_list) >= 12 AND length(vertex_list) % 4 = 0),
  PRIMARY KEY (model_id, idx)
) STRICT, WITHOUT ROWID;

CREATE TABLE mono_circle (
  model_id INTEGER NOT NULL REFERENCES mono_model (id) ON DELETE CASCADE,
  idx      INTEGER NOT NULL CHECK (idx >= 0),
  cx       REAL NOT NULL,
  cy       REAL NOT NULL,
  cz       REAL NOT NULL,
  nx       REAL NOT NULL,
  ny       REAL NOT NULL,
  nz       REAL NOT NULL,
  radius   REAL NOT NULL CHECK (radius > 0),
  PRIMARY KEY (model_id, idx)
) STRICT, WITHOUT ROWID;

CREATE TABLE mono_triple (
  model_id INTEGER NOT NULL REFERENCES mono_model (id) ON DELETE CASCADE,
  i0       INTEGER NOT NULL,
  i1       INTEGER NOT NULL,
  i2       INTEGER NOT NULL,
  type_sig INTEGER NOT NULL,
  links    INTEGER NOT NULL,
  face     INTEGER NOT NULL,
  l01      REAL NOT NULL,
  l02      REAL NOT NULL,
  l12      REAL NOT NULL,
  basis    BLOB NOT NULL CHECK (length(basis) = 120),
  views    BLOB NOT NULL CHECK (length(views) = 32),
  min_sin  REAL NOT NULL,
  PRIMARY KEY (model_id, i0, i1, i2)
) STRICT, WITHOUT ROWID;

CREATE INDEX mono_triple_signature ON mono_triple (type_sig, links);

CREATE TABLE mono_index (
  model_id INTEGER PRIMARY KEY REFERENCES mono_model (id) ON DELETE CASCADE,
  version  INTEGER NOT NULL,
  params   TEXT NOT NULL,
  quads    BLOB NOT NULL,
  digest   TEXT NOT NULL CHECK (length(digest) = 64)
) STRICT;

-- One line a model, for people with the sqlite3 shell.
CREATE VIEW mono_list AS
SELECT name,
       (SELECT count(*) FROM mono_feature WHERE model_id = mono_model.id) AS points,
       (SELECT count(*) FROM mono_edge WHERE model_id = mono_model.id) AS edges,
       (SELECT count(*) FROM mono_face WHERE model_id = mono_model.id) AS faces,
       (SELECT count(*) FROM mono_circle WHERE model_id = mono_model.id) AS circles,
       (SELECT count(*) FROM mono_triple WHERE model_id = mono_model.id) AS triples,
       symmetry, diameter, created, damage
FROM mono_model
ORDER BY name;
