-- Results of examples/sweep_poses.toml: mean DSSIM by trace and warp as published, and how much less it is (percent)
-- aimed at the middle, with poses of cells, with both, and with cells that are shown one by one; eye frames per second.
--   sqlite3 sweeps/sweep_poses/results.sqlite < bench/poses_sweep.sql
.mode column
create temp view run as
  select "trace.file" as trace, "pipeline.warp" as warp, dssim_mean as dssim, fps_avg as fps,
         "stage.chunked.poses" || ' ' || "stage.chunked.swap" || ' ' || "stage.chunked.aim" as kind
  from results where status = 'done';
select p.trace, p.warp, round(p.dssim, 5) as published,
       round(100 * (1 - m.dssim / p.dssim), 1) as middle, round(100 * (1 - c.dssim / p.dssim), 1) as cells,
       round(100 * (1 - b.dssim / p.dssim), 1) as both, round(100 * (1 - s.dssim / p.dssim), 1) as swapped,
       round(p.fps, 1) as published_fps, round(b.fps, 1) as both_fps, round(s.fps, 1) as swapped_fps
from run p join run m using (trace, warp) join run c using (trace, warp) join run b using (trace, warp)
  join run s using (trace, warp)
where p.kind = 'frame frame first' and m.kind = 'frame frame middle' and c.kind = 'cell frame first'
  and b.kind = 'cell frame middle' and s.kind = 'cell cell middle'
order by p.trace, case p.warp when 'none' then 0 when 'quad' then 1 else 2 end;
