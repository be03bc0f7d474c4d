-- Results of examples/sweep_warps.toml, times in ms, means over the traces.
--   sqlite3 sweeps/sweep_warps/results.sqlite < bench/warp_sweep.sql
.mode column
select "clock.queue" as queue, "pipeline.warp" as warp,
       round(avg(mtp_rotation_ms_p50), 1) as rot_p50, round(avg(mtp_rotation_ms_p95), 1) as rot_p95,
       round(avg(mtp_rotation_ms_p99), 1) as rot_p99,
       round(avg(mtp_translation_ms_p50), 1) as tra_p50, round(avg(mtp_translation_ms_p95), 1) as tra_p95,
       round(avg(mtp_translation_ms_p99), 1) as tra_p99,
       round(avg(frame_age_ms_p50), 1) as age_p50, round(avg(frame_age_ms_p95), 1) as age_p95,
       round(100 * avg(missed_ratio), 1) as missed_percent,
       round(avg(dssim_mean), 4) as dssim_mean, round(avg(dssim_p95), 4) as dssim_p95
from results where status = 'done' group by queue, warp
order by queue, case warp when 'none' then 0 when 'quad' then 1 when 'grid' then 2 else 3 end;
