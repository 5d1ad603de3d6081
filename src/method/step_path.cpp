// The library's instance of the bodies in <pliant/method/step_path-inl.h>.
#include <pliant/method/step_path-inl.h>
