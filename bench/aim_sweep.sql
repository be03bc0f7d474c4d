-- Results of examples/sweep_aim.toml: mean DSSIM by trace and warp, and how much less it is with poses for the
-- middle of an eye frame's life.
--   sqlite3 sweeps/sweep_aim/results.sqlite < bench/aim_sweep.sql
.mode column
select a."trace.file" as trace, a."pipeline.warp" as warp,
       round(a.dssim_mean, 5) as first, round(b.dssim_mean, 5) as middle,
       round(100 * (1 - b.dssim_mean / a.dssim_mean), 1) as less_percent,
       round(a.dssim_p95, 4) as first_p95, round(b.dssim_p95, 4) as middle_p95
from results a join results b
  on a."trace.file" = b."trace.file" and a."pipeline.warp" = b."pipeline.warp"
where a."stage.whole_frame.aim" = 'first' and b."stage.whole_frame.aim" = 'middle'
  and a.status = 'done' and b.status = 'done'
order by trace, case warp when 'none' then 0 when 'quad' then 1 when 'grid' then 2 else 3 end;
