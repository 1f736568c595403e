PRAGMA auto_vacuum=0;
PRAGMA application_id=1397116209;
PRAGMA user_version=1;
BEGIN TRANSACTION;
CREATE TABLE attempt(
  job INTEGER NOT NULL REFERENCES job(seq) ON DELETE CASCADE, n INTEGER NOT NULL, started INTEGER NOT NULL,
  ended INTEGER, outcome TEXT, signal INTEGER, exit_status INTEGER, peak_rss INTEGER, cpu_ms INTEGER,
  log TEXT NOT NULL DEFAULT '', PRIMARY KEY(job, n)) STRICT, WITHOUT ROWID;
INSERT INTO "attempt" VALUES(1,1,1795933220511462,1795933220783151,'success',0,0,15556608,3,'');
INSERT INTO "attempt" VALUES(2,1,1795933220894803,1795933220988002,'refused',0,65,16142336,1,'');
INSERT INTO "attempt" VALUES(3,1,1795933221166809,NULL,NULL,NULL,NULL,NULL,NULL,'');
CREATE TABLE blob(
  digest BLOB PRIMARY KEY CHECK(length(digest) = 32), bytes INTEGER NOT NULL,
  store TEXT NOT NULL CHECK(store IN ('file', 'db')), created INTEGER NOT NULL) STRICT, WITHOUT ROWID;
INSERT INTO "blob" VALUES(X'02AD6AF0089795A81408B624B22FCF91EA57D85D1E94FB1BE9C0F66E6AF010A9',42,'file',1795933220502899);
INSERT INTO "blob" VALUES(X'8F3AC4913DC87E47066011CE622CE3A1D666C51FDFD077DE409DE9D3803043B6',42,'file',1795933221382874);
INSERT INTO "blob" VALUES(X'921E737FF1F02EB26ACFC70D60F21CE0B35855E55108163F02E23535A0BCB91F',42,'file',1795933220878859);
INSERT INTO "blob" VALUES(X'E278E3F73E1E80A967BCBD54936A616E16ADBA57D4109A48444B5F8B3D5C017E',42,'file',1795933221131370);
INSERT INTO "blob" VALUES(X'E3B0C44298FC1C149AFBF4C8996FB92427AE41E4649B934CA495991B7852B855',0,'db',1795933220659042);
INSERT INTO "blob" VALUES(X'FB91F9A03C202C5F160EEF644DA6F2F704B19AC5C5F8B4C124E1B0B485AD57A0',42,'db',1795933220659003);
CREATE TABLE event(
  job INTEGER NOT NULL REFERENCES job(seq) ON DELETE CASCADE, n INTEGER NOT NULL, at INTEGER NOT NULL,
  state TEXT NOT NULL, progress INTEGER NOT NULL, stage TEXT NOT NULL, message TEXT NOT NULL,
  PRIMARY KEY(job, n)) STRICT, WITHOUT ROWID;
INSERT INTO "event" VALUES(1,1,1795933220502899,'accepted',0,'','waiting');
INSERT INTO "event" VALUES(1,2,1795933220511462,'running',0,'','started');
INSERT INTO "event" VALUES(1,3,1795933220526065,'running',0,'prepare','step');
INSERT INTO "event" VALUES(1,4,1795933220531555,'running',5,'prepare','step');
INSERT INTO "event" VALUES(1,5,1795933220534922,'running',10,'prepare','step');
INSERT INTO "event" VALUES(1,6,1795933220584294,'running',15,'prepare','step');
INSERT INTO "event" VALUES(1,7,1795933220587887,'running',20,'field','step');
INSERT INTO "event" VALUES(1,8,1795933220591895,'running',25,'field','step');
INSERT INTO "event" VALUES(1,9,1795933220592982,'running',30,'field','step');
INSERT INTO "event" VALUES(1,10,1795933220595737,'running',35,'field','step');
INSERT INTO "event" VALUES(1,11,1795933220596394,'running',40,'trace','step');
INSERT INTO "event" VALUES(1,12,1795933220599844,'running',45,'trace','step');
INSERT INTO "event" VALUES(1,13,1795933220604143,'running',50,'trace','step');
INSERT INTO "event" VALUES(1,14,1795933220605848,'running',55,'trace','step');
INSERT INTO "event" VALUES(1,15,1795933220606990,'running',60,'insert','step');
INSERT INTO "event" VALUES(1,16,1795933220611018,'running',65,'insert','step');
INSERT INTO "event" VALUES(1,17,1795933220613388,'running',70,'insert','step');
INSERT INTO "event" VALUES(1,18,1795933220613706,'running',75,'insert','step');
INSERT INTO "event" VALUES(1,19,1795933220614006,'running',80,'remove','step');
INSERT INTO "event" VALUES(1,20,1795933220615805,'running',85,'remove','step');
INSERT INTO "event" VALUES(1,21,1795933220616119,'running',90,'remove','step');
INSERT INTO "event" VALUES(1,22,1795933220616421,'running',95,'remove','step');
INSERT INTO "event" VALUES(1,23,1795933220658946,'successful',100,'write','3 parts');
INSERT INTO "event" VALUES(2,1,1795933220878859,'accepted',0,'','waiting');
INSERT INTO "event" VALUES(2,2,1795933220894803,'running',0,'','started');
INSERT INTO "event" VALUES(2,3,1795933221023505,'failed',0,'','the mesh is a Moebius strip');
INSERT INTO "event" VALUES(3,1,1795933221131370,'accepted',0,'','waiting');
INSERT INTO "event" VALUES(3,2,1795933221166809,'running',0,'','started');
INSERT INTO "event" VALUES(3,3,1795933221255168,'running',0,'prepare','step');
INSERT INTO "event" VALUES(3,4,1795933221270720,'running',5,'prepare','step');
INSERT INTO "event" VALUES(3,5,1795933221311149,'running',10,'prepare','step');
INSERT INTO "event" VALUES(3,6,1795933221363053,'running',15,'prepare','step');
INSERT INTO "event" VALUES(4,1,1795933221382874,'accepted',0,'','waiting');
CREATE TABLE idempotency(
  principal INTEGER NOT NULL, route TEXT NOT NULL, key TEXT NOT NULL, fingerprint BLOB NOT NULL, job TEXT NOT NULL,
  at INTEGER NOT NULL, PRIMARY KEY(principal, route, key)) STRICT, WITHOUT ROWID;
INSERT INTO "idempotency" VALUES(0,'/api/v1/processes/decompose/execution','kept',X'7B1F3B2EE60B0CB5E188660D34AE2F4F8CF2E85E5E503EB715E5DFC11BAE51A3','01a225f6-2e96-72fd-bdf6-c4fced693c60',1795933220502899);
CREATE TABLE job(
  seq INTEGER PRIMARY KEY AUTOINCREMENT, id TEXT UNIQUE NOT NULL,
  principal INTEGER NOT NULL DEFAULT 0 REFERENCES principal(id),
  process TEXT NOT NULL, version TEXT NOT NULL,
  state TEXT NOT NULL CHECK(state IN ('accepted', 'running', 'successful', 'failed', 'dismissed')),
  run_after INTEGER NOT NULL,
  attempt INTEGER NOT NULL DEFAULT 0, crashes INTEGER NOT NULL DEFAULT 0, errors INTEGER NOT NULL DEFAULT 0,
  interruptions INTEGER NOT NULL DEFAULT 0,
  token BLOB, rev INTEGER NOT NULL DEFAULT 1, ev INTEGER NOT NULL DEFAULT 0,
  progress INTEGER NOT NULL DEFAULT 0, stage TEXT NOT NULL DEFAULT '', message TEXT NOT NULL DEFAULT '',
  problem TEXT, report TEXT, params TEXT NOT NULL, reuse_key BLOB, reused_from TEXT,
  input BLOB REFERENCES blob(digest), input_name TEXT NOT NULL DEFAULT '', input_info TEXT,
  tag TEXT NOT NULL DEFAULT '',
  created INTEGER NOT NULL, updated INTEGER NOT NULL, started INTEGER, finished INTEGER,
  expires INTEGER NOT NULL) STRICT;
INSERT INTO "job" VALUES(1,'01a225f6-2e96-72fd-bdf6-c4fced693c60',0,'decompose','0.1.0','successful',1795933220502899,1,0,0,0,NULL,24,23,100,'write','3 parts',NULL,'{"e_max_met":true,"notes":[],"patches":3}','{"creases":40,"e_max":0.02,"effort":"normal","max_sides":6,"min_bend_radius":"off","morph":"reduced","normal_deviation":"off","ruling_spacing_max":"off","ruling_spacing_min":"off","scale":1,"seed":0,"self_seams":true,"symmetry":"off","t_junctions":true}',X'9837AF069248491EAB27008058A00598E4EDA3503893C8595C88823EC2F9BD45',NULL,X'02AD6AF0089795A81408B624B22FCF91EA57D85D1E94FB1BE9C0F66E6AF010A9','work-10.obj','{"bbox":{"max":[1,1,0],"min":[0,0,0]},"bboxDiagonal":1.5,"bytes":42,"faces":1,"format":"obj","name":"work-10.obj","scale":1,"sha256":"02ad6af0089795a81408b624b22fcf91ea57d85d1e94fb1be9c0f66e6af010a9","sizeMm":[1,1,0],"unitAssumed":"1 unit = 1 mm","vertices":3}','',1795933220502899,1795933220658946,1795933220511462,1795933220658918,4949533220502899);
INSERT INTO "job" VALUES(2,'01a225f6-300e-7d67-8cc3-61c4340a0e12',0,'decompose','0.1.0','failed',1795933220878859,1,0,1,0,NULL,4,3,0,'','the mesh is a Moebius strip','{"detail":"the mesh is a Moebius strip","fix":"cut it open","retryable":false,"status":422,"title":"The mesh cannot be decomposed","type":"urn:sheetform:problem:unsupported-mesh","where":"face 7"}',NULL,'{"creases":40,"e_max":0.02,"effort":"normal","max_sides":6,"min_bend_radius":"off","morph":"reduced","normal_deviation":"off","ruling_spacing_max":"off","ruling_spacing_min":"off","scale":1,"seed":0,"self_seams":true,"symmetry":"off","t_junctions":true}',X'D9F098241E5192D8798BBC6D59470C8AFC93BE7F179AE416321A64594E01BAA1',NULL,X'921E737FF1F02EB26ACFC70D60F21CE0B35855E55108163F02E23535A0BCB91F','refuse.obj','{"bbox":{"max":[1,1,0],"min":[0,0,0]},"bboxDiagonal":1.5,"bytes":42,"faces":1,"format":"obj","name":"refuse.obj","scale":1,"sha256":"921e737ff1f02eb26acfc70d60f21ce0b35855e55108163f02e23535a0bcb91f","sizeMm":[1,1,0],"unitAssumed":"1 unit = 1 mm","vertices":3}','',1795933220878859,1795933221023505,1795933220894803,1795933221023472,4949533220878859);
INSERT INTO "job" VALUES(3,'01a225f6-310b-7b5c-a3fb-0723b40769e9',0,'decompose','0.1.0','running',1795933221131370,1,0,0,0,X'61DCC4ED4E87476768192DEE6264E487',7,6,15,'prepare','step',NULL,NULL,'{"creases":40,"e_max":0.02,"effort":"normal","max_sides":6,"min_bend_radius":"off","morph":"reduced","normal_deviation":"off","ruling_spacing_max":"off","ruling_spacing_min":"off","scale":1,"seed":0,"self_seams":true,"symmetry":"off","t_junctions":true}',X'09C149BC678BCB986E83FC186CD8FBDE796B8712DF7DE6E6B2E8E354823F3945',NULL,X'E278E3F73E1E80A967BCBD54936A616E16ADBA57D4109A48444B5F8B3D5C017E','work-300.obj','{"bbox":{"max":[1,1,0],"min":[0,0,0]},"bboxDiagonal":1.5,"bytes":42,"faces":1,"format":"obj","name":"work-300.obj","scale":1,"sha256":"e278e3f73e1e80a967bcbd54936a616e16adba57d4109a48444b5f8b3d5c017e","sizeMm":[1,1,0],"unitAssumed":"1 unit = 1 mm","vertices":3}','',1795933221131370,1795933221363053,1795933221166809,NULL,4949533221131370);
INSERT INTO "job" VALUES(4,'01a225f6-3206-71d9-a247-bce016a140c5',0,'decompose','0.1.0','accepted',1795933221382874,0,0,0,0,NULL,2,1,0,'','waiting',NULL,NULL,'{"creases":40,"e_max":0.02,"effort":"normal","max_sides":6,"min_bend_radius":"off","morph":"reduced","normal_deviation":"off","ruling_spacing_max":"off","ruling_spacing_min":"off","scale":1,"seed":0,"self_seams":true,"symmetry":"off","t_junctions":true}',X'6EB2F8808F281D5DB306CB283B7960E29B2E469C53308BCE120896A5B05EDE16',NULL,X'8F3AC4913DC87E47066011CE622CE3A1D666C51FDFD077DE409DE9D3803043B6','work-10.obj','{"bbox":{"max":[1,1,0],"min":[0,0,0]},"bboxDiagonal":1.5,"bytes":42,"faces":1,"format":"obj","name":"work-10.obj","scale":1,"sha256":"8f3ac4913dc87e47066011ce622ce3a1d666c51fdfd077de409de9d3803043b6","sizeMm":[1,1,0],"unitAssumed":"1 unit = 1 mm","vertices":3}','',1795933221382874,1795933221382874,NULL,NULL,4949533221382874);
CREATE TABLE output(
  job INTEGER NOT NULL REFERENCES job(seq) ON DELETE CASCADE, position INTEGER NOT NULL, name TEXT NOT NULL,
  media TEXT NOT NULL, digest BLOB NOT NULL REFERENCES blob(digest), PRIMARY KEY(job, name)) STRICT, WITHOUT ROWID;
INSERT INTO "output" VALUES(1,2,'empty.txt','text/plain',X'E3B0C44298FC1C149AFBF4C8996FB92427AE41E4649B934CA495991B7852B855');
INSERT INTO "output" VALUES(1,0,'layout.svg','image/svg+xml',X'FB91F9A03C202C5F160EEF644DA6F2F704B19AC5C5F8B4C124E1B0B485AD57A0');
CREATE TABLE principal(
  id INTEGER PRIMARY KEY, name TEXT UNIQUE NOT NULL, created INTEGER NOT NULL) STRICT;
INSERT INTO "principal" VALUES(0,'anonymous',0);
CREATE INDEX job_ready ON job(principal, run_after, seq) WHERE state = 'accepted';
CREATE INDEX job_running ON job(principal) WHERE state = 'running';
CREATE INDEX job_list ON job(created DESC, id DESC);
CREATE INDEX job_list_principal ON job(principal, created DESC, id DESC);
CREATE INDEX job_reuse ON job(reuse_key) WHERE state = 'successful';
CREATE INDEX job_expiry ON job(expires) WHERE state NOT IN ('accepted', 'running');
CREATE INDEX job_input ON job(input);
CREATE INDEX output_digest ON output(digest);
CREATE INDEX idempotency_age ON idempotency(at);
DELETE FROM "sqlite_sequence";
INSERT INTO "sqlite_sequence" VALUES('job',4);
COMMIT;
