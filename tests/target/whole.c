/** An image that holds the libraries as a whole, for measuring. */
int main(void)
{
    return 0;
}
