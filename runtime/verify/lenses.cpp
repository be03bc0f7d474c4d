// Lens models of all device profiles: inverse, fold-over.
#include <cmath>

#include "hmd_sim/device_profile.hpp"
#include "runtime/verify/verify.hpp"

namespace brace {

void verify_lenses(const VerifySubjects& subjects, Claims& claims, VerifyFigures&) {
  Largest round_trip, iterations, falling, beyond, edge;
  int channels = 0, folding = 0, wrong_branches = 0;
  for (const sim::DeviceProfile& profile : sim::list_device_profiles(subjects.data_folder / "devices")) {
    if (!profile.has_lens_data()) continue;
    for (const sim::EyeProfile& eye : profile.eyes) {
      for (const sim::LensChannel& channel : eye.lens.rgb) {
        ++channels;
        constexpr double r_max = 4.0;
        const sim::LensKind kind = eye.lens.kind;
        const double usable = subjects.fold_over_radius(kind, channel.k, r_max);
        double before = 0.0;
        constexpr int places = 200;
        for (int i = 1; i <= places; ++i) {
          const double r = usable * i / places * (1 - 1e-9);
          const double source = subjects.lens_forward(kind, channel.k, r);
          falling.see(before - source);  // it grows up to the usable radius
          before = source;
          int taken = 0;
          const auto back = subjects.lens_inverse(kind, channel.k, source, usable, &taken);
          if (i < places * 9 / 10) iterations.see(taken);
          // Where the mapping is flat an error of the source is a large one of the radius.
          round_trip.see(back ? std::abs(subjects.lens_forward(kind, channel.k, *back) - source) / source
                              : NAN);
          if (i < places * 9 / 10) edge.see(back ? std::abs(*back - r) / r : NAN);
        }
        // A fold: just past the largest radius the mapping turns back, and nothing there may be returned. (A
        // pole of a rational model ends the usable radius too; before it every direction is reached.)
        const double after = subjects.lens_forward(kind, channel.k, usable * 1.001);
        if (usable < r_max && after > 0 && after < 2 * before) {
          ++folding;
          wrong_branches +=
              subjects.lens_inverse(kind, channel.k, before * (1 + 1e-6), usable, nullptr).has_value();
          beyond.see(after / before - 1);
        }
      }
    }
  }
  claims.add("channels of lenses with data", channels, at_least(6));
  claims.add("channels that fold over within 4 lens units", folding, at_least(1));
  claims.add("lens(inverse(s)) against s, up to the fold: largest relative error", round_trip.value(),
             at_most(1e-11));
  claims.add("inverse(lens(r)) against r, up to 0.9 of it: largest relative error", edge.value(),
             at_most(1e-8));
  claims.add("iterations of the inverse up to 0.9 of it, at most", iterations.value(), at_most(13));
  claims.add("lens falls before its usable radius by", falling.value(), at_most(0));
  claims.add("points returned from beyond a fold", wrong_branches, exactly(0));
  claims.add("growth of the lens 0.1 % beyond its usable radius", beyond.value(), at_most(1e-5));
}

}  // namespace brace
