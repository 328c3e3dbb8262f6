-- The first schema. Every table, column and unit is explained in README.md beside this file.

CREATE TABLE setting (
  name  TEXT PRIMARY KEY,
  value ANY NOT NULL
) STRICT, WITHOUT ROWID;

INSERT INTO setting (name, value) VALUES ('generation', 0);

CREATE TABLE scene (
  id           INTEGER PRIMARY KEY AUTOINCREMENT,
  name         TEXT NOT NULL UNIQUE CHECK (length(name) BETWEEN 1 AND 128),
  created      TEXT NOT NULL,
  last_version INTEGER NOT NULL DEFAULT 0
) STRICT;

CREATE TABLE segment (
  id       INTEGER PRIMARY KEY AUTOINCREMENT,
  format   INTEGER NOT NULL,
  bytes    INTEGER NOT NULL CHECK (bytes >= 0),
  manifest TEXT NOT NULL,
  sha256   TEXT NOT NULL CHECK (length(sha256) = 64)
) STRICT;

CREATE TABLE segment_array (
  id         INTEGER PRIMARY KEY,
  segment_id INTEGER NOT NULL REFERENCES segment (id) ON DELETE CASCADE,
  position   INTEGER NOT NULL CHECK (position >= 0),
  name       TEXT NOT NULL,
  dtype      TEXT NOT NULL,
  shape      TEXT NOT NULL,
  bytes      INTEGER NOT NULL CHECK (bytes >= 0),
  sha256     TEXT NOT NULL CHECK (length(sha256) = 64),
  UNIQUE (segment_id, position)
) STRICT;

CREATE TABLE segment_chunk (
  array_id INTEGER NOT NULL REFERENCES segment_array (id) ON DELETE CASCADE,
  n        INTEGER NOT NULL CHECK (n >= 0),
  data     BLOB NOT NULL CHECK (length(data) BETWEEN 1 AND 4194304),
  PRIMARY KEY (array_id, n)
) STRICT;

CREATE TABLE scene_version (
  scene_id           INTEGER NOT NULL REFERENCES scene (id) ON DELETE CASCADE,
  version            INTEGER NOT NULL CHECK (version >= 1),
  segment_id         INTEGER NOT NULL UNIQUE REFERENCES segment (id),
  state              TEXT NOT NULL CHECK (state IN ('building', 'active', 'retired')),
  created            TEXT NOT NULL,
  retired            TEXT,
  damage             TEXT,
  kind               TEXT NOT NULL,
  points             INTEGER NOT NULL,
  keypoints          INTEGER NOT NULL,
  voxel_m            REAL NOT NULL,
  normal_radius_m    REAL NOT NULL,
  shot_radius_m      REAL NOT NULL,
  keypoint_spacing_m REAL NOT NULL,
  keypoint_method    TEXT NOT NULL,
  up_x               REAL,
  up_y               REAL,
  up_z               REAL,
  sources            TEXT NOT NULL,
  warnings           TEXT NOT NULL,
  PRIMARY KEY (scene_id, version)
) STRICT;

CREATE UNIQUE INDEX scene_version_active ON scene_version (scene_id) WHERE state = 'active';

CREATE TABLE tag (
  scene_id INTEGER NOT NULL REFERENCES scene (id) ON DELETE CASCADE,
  key      TEXT NOT NULL,
  value    TEXT NOT NULL,
  PRIMARY KEY (scene_id, key)
) STRICT, WITHOUT ROWID;

CREATE TABLE landmark (
  scene_id INTEGER NOT NULL REFERENCES scene (id) ON DELETE CASCADE,
  name     TEXT NOT NULL,
  min_x_m  REAL NOT NULL,
  min_y_m  REAL NOT NULL,
  min_z_m  REAL NOT NULL,
  max_x_m  REAL NOT NULL CHECK (max_x_m > min_x_m),
  max_y_m  REAL NOT NULL CHECK (max_y_m > min_y_m),
  max_z_m  REAL NOT NULL CHECK (max_z_m > min_z_m),
  PRIMARY KEY (scene_id, name)
) STRICT, WITHOUT ROWID;

-- One line a scene, for people with the sqlite3 shell.
CREATE VIEW scene_list AS
SELECT scene.name, scene_version.version, scene_version.kind, scene_version.points,
       scene_version.keypoints, segment.bytes, scene_version.created, scene_version.damage
FROM scene
JOIN scene_version ON scene_version.scene_id = scene.id AND scene_version.state = 'active'
JOIN segment ON segment.id = scene_version.segment_id
ORDER BY scene.name;
