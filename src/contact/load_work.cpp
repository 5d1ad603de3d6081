// The library's instance of the function bodies in <pliant/contact/load_work-inl.h>.
#include <pliant/contact/load_work-inl.h>
