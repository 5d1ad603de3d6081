// The compiled function bodies of project_frames-inl.h.
#include <pliant/project/project_frames-inl.h>
