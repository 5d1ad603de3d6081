// The library's instance of the function bodies in <pliant/contact/impact_timing-inl.h>.
#include <pliant/contact/impact_timing-inl.h>
