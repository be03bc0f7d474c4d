// Takes every sample, as skip/none: what a run casts with is the stage that was chosen in this one's place.
