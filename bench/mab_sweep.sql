-- Results of examples/sweep_mab.toml: error of each map over that of the radial one at equal rays, means over the volumes.
-- Below 1 a map is better. Points where a map asks for fewer rays than ray_share are left out.
--   sqlite3 sweeps/sweep_mab/results.sqlite < bench/mab_sweep.sql
.mode column
select m."device.profile" as profile, m."stage.mab.map" as map, count(*) as points,
       round(avg(m.dssim_mean / r.dssim_mean), 3) as dssim, round(max(m.dssim_mean / r.dssim_mean), 3) as worst,
       round(avg(m.weighted_rmse_mean / r.weighted_rmse_mean), 3) as weighted,
       round(max(m.weighted_rmse_mean / r.weighted_rmse_mean), 3) as weighted_worst
from results m join results r
  on r."stage.mab.map" = 'radius' and r."device.profile" = m."device.profile" and r."scene.volume" = m."scene.volume"
 and r."stage.mab.ray_share" = m."stage.mab.ray_share"
where m.status = 'done' and r.status = 'done' and m."stage.mab.map" <> 'radius' and r.dssim_mean > 0
  and m.rays > 0.97 * r.rays
group by profile, map order by profile, map;
