// Include after local_size_x. Dispatches over many items use x and y of the work-groups as one index.
#ifndef BRACE_SKIP_LINEAR_GLSL
#define BRACE_SKIP_LINEAR_GLSL
uint linear_invocation() {
  return (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
}
#endif
