# docker build -t scancal . && docker run --rm -u "$(id -u):$(id -g)" -v "$PWD:/data" scancal refine mine --out=mine
FROM debian:12 AS build
COPY . /scancal
RUN /scancal/scripts/package

FROM debian:12-slim
COPY --from=build /scancal/build/scancal_*.deb /tmp/
RUN apt-get update && apt-get install -y --no-install-recommends /tmp/scancal_*.deb weasyprint \
  && rm -rf /var/lib/apt/lists/* /tmp/scancal_*.deb
ENV XDG_CACHE_HOME=/tmp
WORKDIR /data
ENTRYPOINT ["scancal"]
