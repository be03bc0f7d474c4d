-- Results of examples/sweep_poses.toml: mean DSSIM by trace and warp, and how much less it is than as published with
-- poses for the middle of an eye frame's life, with poses of their own for cells, and with both.
--   sqlite3 sweeps/sweep_poses/results.sqlite < bench/poses_sweep.sql
.mode column
create temp view run as
  select "trace.file" as trace, "pipeline.warp" as warp, "stage.chunked.poses" || ' ' || "stage.chunked.aim" as kind,
         dssim_mean as dssim, eye_frames_per_s
  from (select *, fps_avg as eye_frames_per_s from results where status = 'done');
select p.trace, p.warp, round(p.dssim, 5) as published, round(m.dssim, 5) as middle, round(c.dssim, 5) as cells,
       round(b.dssim, 5) as both, round(100 * (1 - m.dssim / p.dssim), 1) as middle_less_percent,
       round(100 * (1 - c.dssim / p.dssim), 1) as cells_less_percent,
       round(100 * (1 - b.dssim / p.dssim), 1) as both_less_percent,
       round(p.eye_frames_per_s, 2) as published_fps, round(b.eye_frames_per_s, 2) as both_fps
from run p join run m join run c join run b
  on p.trace = m.trace and p.trace = c.trace and p.trace = b.trace
  and p.warp = m.warp and p.warp = c.warp and p.warp = b.warp
where p.kind = 'frame first' and m.kind = 'frame middle' and c.kind = 'cell first' and b.kind = 'cell middle'
order by p.trace, case p.warp when 'none' then 0 when 'quad' then 1 else 2 end;
