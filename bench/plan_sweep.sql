-- The planner against every subset of what could be left out, scene by scene: results of examples/sweep_plan.toml.
--   sqlite3 sweeps/sweep_plan/results.sqlite < bench/plan_sweep.sql
-- A subset counts if its error is at most 0.002 DSSIM above that with everything on.
.mode column
create temp view run as
  select "scene.volume" || ' ' || "scene.transfer_function" || ' ' || "trace.neck.motion" || ' ' || "device.profile" as scene,
         "plan.leave_out" as choice, gpu_ms_frame as ms, dssim_mean as dssim
  from results where status = 'done';
create temp view everything as select * from run where choice = 'none';
create temp view planned as select * from run where choice = 'auto';
create temp view best as
  select run.scene as scene, min(run.ms) as ms from run join everything on run.scene = everything.scene
  where run.choice not in ('none', 'auto') and run.dssim <= everything.dssim + 0.002 group by run.scene;
create temp view judged as
  select planned.scene as scene, round(everything.ms, 3) as everything_ms, round(planned.ms, 3) as planned_ms,
         round(best.ms, 3) as best_ms, round(100 * (planned.ms / best.ms - 1), 1) as behind_best_percent,
         round(100 * (1 - planned.ms / everything.ms), 1) as saved_percent,
         round(planned.dssim - everything.dssim, 5) as added_dssim
  from planned join best on planned.scene = best.scene join everything on planned.scene = everything.scene;
select * from judged order by saved_percent;
select count(*) as scenes, max(behind_best_percent) as behind_best_max, min(saved_percent) as saved_min,
       max(added_dssim) as added_dssim_max
from judged;
select saved_percent as saved_median from judged order by saved_percent limit 1 offset (select count(*) / 2 from judged);
