// The library's instance of the bodies in <pliant/project/project_frames-inl.h>.
#include <pliant/project/project_frames-inl.h>
