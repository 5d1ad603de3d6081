// The library's instance of the function bodies in <pliant/contact/damping_work-inl.h>.
#include <pliant/contact/damping_work-inl.h>
