// The library's instance of the bodies in <pliant/project/follow_paths-inl.h>.
#include <pliant/project/follow_paths-inl.h>
