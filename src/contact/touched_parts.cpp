// The library's instance of the function bodies in <pliant/contact/touched_parts-inl.h>.
#include <pliant/contact/touched_parts-inl.h>
