// The library's instance of the function bodies in <pliant/contact/impact_sequence-inl.h>.
#include <pliant/contact/impact_sequence-inl.h>
