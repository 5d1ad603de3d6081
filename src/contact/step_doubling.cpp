// The library's instance of the function bodies in <pliant/contact/step_doubling-inl.h>.
#include <pliant/contact/step_doubling-inl.h>
