// No empty-space skipping: every sample of the lattice is taken (brace/skip.glsl).
