// The library's instance of the function bodies in <pliant/method/step_path-inl.h>.
#include <pliant/method/step_path-inl.h>
